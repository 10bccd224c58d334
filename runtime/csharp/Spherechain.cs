// SPDX-License-Identifier: MIT
// Spherechain for C#: a Model, what is wrong with what it was given, and the mirror between right- and left-handed axes. A Body
// is in Spherechain.Body.cs, a Response in Spherechain.Response.cs. For netstandard 2.0, Unity 2021 and mono; C# 7. Objects
// allocate when they are made, never in a frame. Every error is a SpherechainException. docs/csharp.md is the guide.
using System;
using System.IO;
using System.Text;

namespace Spherechain
{
    /// <summary>What the library refuses: a code, the field that it is about, and a sentence.</summary>
    public sealed class SpherechainException : Exception
    {
        public Code Code { get; private set; }
        public Field Field { get; private set; }
        /// <summary>As the C headers spell it: "pose.bones".</summary>
        public string FieldName { get; private set; }

        internal SpherechainException(Code code, Field field, string text) : base(text)
        {
            Code = code;
            Field = field;
            FieldName = Text.FieldOf(field);
        }
    }

    /// <summary>Texts and checks that the classes share.</summary>
    internal static unsafe class Text
    {
        internal const int MessageSize = 256;

        internal static string Of(byte* text)
        {
            if (text == null) return null;
            int length = 0;
            while (text[length] != 0) ++length;
            return length == 0 ? "" : Encoding.UTF8.GetString(text, length);
        }

        internal static string FieldOf(Field field)
        {
            // Without the library there are no texts, but there is an exception to throw.
            try { return Of(Native.sc_field_name(field)); } catch (DllNotFoundException) { return field.ToString(); }
        }

        internal static void Check(Status status, byte* message = null)
        {
            if (status.Code == Code.Ok) return;
            string text = Of(message);
            if (string.IsNullOrEmpty(text))
            {
                text = Of(Native.sc_code_text(status.Code));
                if (status.Field != Field.None) text = Of(Native.sc_field_name(status.Field)) + ": " + text;
            }
            throw new SpherechainException(status.Code, status.Field, text);
        }

        /// <summary>How many floats a matrix has.</summary>
        internal static int Floats(MatrixLayout layout)
        {
            if (layout == MatrixLayout.Rows3x4 || layout == MatrixLayout.Columns3x4) return 12;
            if (layout == MatrixLayout.Rows4x4 || layout == MatrixLayout.Columns4x4) return 16;
            throw new SpherechainException(Code.BadValue, Field.BoneLayout, "say how the matrices lie in memory: a MatrixLayout");
        }

        internal static Native.Pose PoseOf(float* palette, int floats, MatrixLayout layout)
        {
            Native.Pose pose = default(Native.Pose);
            pose.Bones = palette;
            pose.BoneCount = Size(floats / Floats(layout));
            pose.BoneLayout = layout;
            return pose;
        }

        internal static UIntPtr Size(int count) { return new UIntPtr((uint)count); }
        internal static int Int(UIntPtr size) { return checked((int)size.ToUInt64()); }

        internal static void Require(object value, Field field, string what)
        {
            if (value == null) throw new SpherechainException(Code.Null, field, what + " is null");
        }
    }

    /// <summary>A baked character and the engine's joints. It never changes: any number of threads and bodies may share one.</summary>
    public sealed unsafe class Model : IDisposable
    {
        IntPtr handle;
        readonly Native.AssetInfo info;

        /// <summary>For calls of Native. Throws where the model is disposed.</summary>
        public IntPtr Handle
        {
            get
            {
                if (handle == IntPtr.Zero) throw new SpherechainException(Code.NotOpen, Field.Asset, "the model is disposed");
                return handle;
            }
        }

        public int SphereCount { get { return Text.Int(info.SphereCount); } }
        public int BoneCount { get { return Text.Int(info.BoneCount); } }
        public int PartCount { get { return Text.Int(info.PartCount); } }
        public int MorphCount { get { return Text.Int(info.MorphCount); } }
        public int RegionCount { get { return Text.Int(info.RegionCount); } }
        public int VertexCount { get { return Text.Int(info.VertexCount); } }
        public int TriangleCount { get { return Text.Int(info.TriangleCount); } }
        public float MetresPerUnit { get { return info.MetresPerUnit; } }
        public float Height { get { return info.Height; } }
        /// <summary>The character's own axes: Left x Up = Forward, in the source's right-handed space.</summary>
        public Vec3 Origin { get { return info.Origin; } }
        public Vec3 Left { get { return info.Left; } }
        public Vec3 Up { get { return info.Up; } }
        public Vec3 Forward { get { return info.Forward; } }
        public string Writer { get; private set; }
        public string SourceFile { get; private set; }
        public string SourceSha256 { get; private set; }
        public string Settings { get; private set; }
        /// <summary>Names by number. The name of the bone for vertices that no bone moves is empty.</summary>
        public string[] PartNames { get; private set; }
        public string[] BoneNames { get; private set; }
        public string[] MorphNames { get; private set; }
        public string[] RegionNames { get; private set; }

        /// <summary>`file`: the .sphc file's bytes; they are verified and copied. `joints`: the names of the engine's joints in the
        /// order of its palettes; null: palettes come in the asset's order. `inverseBinds`: a matrix for each joint, in `layout`;
        /// null: not compared. With them, another rest pose, unit or handedness is refused (Code.OtherBind).</summary>
        public Model(byte[] file, string[] joints = null, float[] inverseBinds = null,
                     MatrixLayout layout = MatrixLayout.LayoutUnset)
        {
            Text.Require(file, Field.Data, "the file");
            int count = joints == null ? 0 : joints.Length;
            int floats = inverseBinds == null ? 0 : Text.Floats(layout);
            for (int i = 0; i < count; ++i) Text.Require(joints[i], Field.Joints, "the name of joint " + i);
            if (inverseBinds != null && inverseBinds.Length < count * floats)
            {
                throw new SpherechainException(Code.TooSmall, Field.Joints, "fewer inverse bind matrices than joints");
            }
            byte[] names = Encoding.UTF8.GetBytes(count == 0 ? "" : string.Join("\0", joints) + "\0");
            Native.Bone[] bones = new Native.Bone[count + 1];  // `fixed` makes null of an empty array
            byte* message = stackalloc byte[Text.MessageSize];
            message[0] = 0;
            fixed (byte* data = file.Length == 0 ? new byte[1] : file, name = names)
            fixed (float* binds = inverseBinds)
            fixed (Native.Bone* bone = bones)
            fixed (IntPtr* made = &handle)
            {
                int at = 0;
                for (int i = 0; i < count; at += Encoding.UTF8.GetByteCount(joints[i++]) + 1)
                {
                    bone[i].Name = name + at;
                    bone[i].InverseBind = binds == null ? null : binds + (long)i * floats;
                }
                Native.ModelDef def = default(Native.ModelDef);
                def.Data = data;
                def.Size = Text.Size(file.Length);
                def.Joints = joints == null ? null : bone;
                def.JointCount = Text.Size(count);
                def.InverseBindLayout = inverseBinds == null ? MatrixLayout.Columns4x4 : layout;
                Text.Check(Native.sc_create_model(Native.AbiVersion, &def, made, message, Text.Size(Text.MessageSize)), message);
            }
            Native.Asset* asset = Native.sc_get_asset(handle);
            info = Native.sc_asset_get_info(asset);
            Writer = Text.Of(info.Writer);
            SourceFile = Text.Of(info.SourceFile);
            SourceSha256 = Text.Of(info.SourceSha256);
            Settings = Text.Of(info.Settings);
            PartNames = new string[PartCount];
            BoneNames = new string[BoneCount];
            MorphNames = new string[MorphCount];
            RegionNames = new string[RegionCount];
            for (int i = 0; i < PartCount; ++i) PartNames[i] = Text.Of(Native.sc_asset_part(asset, Text.Size(i)).Name);
            for (int i = 0; i < BoneCount; ++i) BoneNames[i] = Text.Of(Native.sc_asset_bone(asset, Text.Size(i)).Name);
            for (int i = 0; i < MorphCount; ++i) MorphNames[i] = Text.Of(Native.sc_asset_morph_name(asset, Text.Size(i)));
            for (int i = 0; i < RegionCount; ++i) RegionNames[i] = Text.Of(Native.sc_asset_region_name(asset, Text.Size(i)));
        }

        public Model(string path) : this(File.ReadAllBytes(path)) { }

        /// <summary>The rest pose's self-check, once: `palette` of the bind pose, the character off the origin and turned. Throws
        /// (Code.OtherBind) where the matrices are not skinning matrices of this character, and names the bone.</summary>
        public void CheckRest(float[] palette, MatrixLayout layout)
        {
            Text.Require(palette, Field.Bones, "the palette");
            byte* message = stackalloc byte[Text.MessageSize];
            message[0] = 0;
            fixed (float* first = palette)
            {
                Native.Pose pose = Text.PoseOf(first, palette.Length, layout);
                Text.Check(Native.sc_check_rest(Handle, &pose, message, Text.Size(Text.MessageSize)), message);
            }
            GC.KeepAlive(this);
        }

        /// <summary>Null of what is no part: Native.Floor.</summary>
        public string PartName(uint part) { return part < PartNames.Length ? PartNames[part] : null; }
        /// <summary>The engine's joint that moves a part; Native.NoJoint where none does.</summary>
        public uint PartJoint(uint part) { return Kept(Native.sc_get_part_joint(Handle, part)); }
        /// <summary>The bone that a part follows, or -1.</summary>
        public int PartBone(int part) { return Part(part).Bone; }
        /// <summary>The part that a part hangs on, or -1.</summary>
        public int PartParent(int part) { return Part(part).Parent; }
        /// <summary>Native.SideLeft or Native.SideRight, the character's own; 0: neither.</summary>
        public int PartSide(int part) { return Part(part).Side; }
        /// <summary>What a triangle of the source belongs to; Native.NoPart where it was left out of the skin.</summary>
        public Triangle Triangle(uint triangle) { return Kept(Native.sc_get_triangle(Handle, triangle)); }
        /// <summary>A sphere at rest, in source units.</summary>
        public RestSphere RestSphere(int sphere) { return Kept(Native.sc_asset_sphere(Asset, Index(sphere, SphereCount))); }
        /// <summary>A length in the units of a pose that has the asset's scale.</summary>
        public float Millimetres(float length) { return 1000 * length * MetresPerUnit; }

        /// <summary>From the rest pose to the bone's space: 12 floats, Rows3x4, written to `matrix` from `at` on.</summary>
        public void InverseBind(int bone, float[] matrix, int at = 0)
        {
            float* found = Native.sc_asset_bone(Asset, Index(bone, BoneCount)).InverseBind;
            Text.Require(matrix, Field.Output, "the matrix");
            if (at < 0 || at > matrix.Length - 12) throw new SpherechainException(Code.TooSmall, Field.Output, "12 floats are written");
            for (int i = 0; i < 12; ++i) matrix[at + i] = found == null ? (i % 5 == 0 ? 1 : 0) : found[i];
            GC.KeepAlive(this);
        }

        /// <summary>For Query.IgnoredParts: a bit for each of these parts.</summary>
        public ulong[] PartSet(params int[] parts)
        {
            ulong[] words = new ulong[(PartCount + 63) / 64];
            foreach (int part in parts) words[Index(part, PartCount).ToUInt64() / 64] |= 1ul << (part % 64);
            return words;
        }

        /// <summary>For Query.PartPairs: a bit for each of these pairs, of a part of this model and one of `other`, which may be this.</summary>
        public ulong[] PairSet(Model other, params Pair[] pairs)
        {
            ulong[] words = new ulong[(PartCount * other.PartCount + 63) / 64];
            foreach (Pair pair in pairs)
            {
                Index((int)pair.B, other.PartCount);
                int bit = (int)Index((int)pair.A, PartCount).ToUInt64() * other.PartCount + (int)pair.B;
                words[bit / 64] |= 1ul << (bit % 64);
            }
            return words;
        }

        internal Native.Asset* Asset { get { return Native.sc_get_asset(Handle); } }

        Native.Part Part(int part) { return Native.sc_asset_part(Asset, Index(part, PartCount)); }

        static UIntPtr Index(int index, int count)
        {
            if (index < 0 || index >= count) throw new SpherechainException(Code.BadValue, Field.Index, index + " is none of " + count);
            return Text.Size(index);
        }

        T Kept<T>(T value)
        {
            GC.KeepAlive(this);
            return value;
        }

        /// <summary>Its bodies are of no use any more.</summary>
        public void Dispose()
        {
            if (handle != IntPtr.Zero) Native.sc_destroy_model(handle);
            handle = IntPtr.Zero;
            GC.SuppressFinalize(this);
        }

        ~Model() { if (handle != IntPtr.Zero) Native.sc_destroy_model(handle); }
    }

    public enum Axis { None, X, Y, Z }

    /// <summary>Between the source file's right-handed space and an engine's left-handed one, whose importer turned one axis
    /// around and perhaps changed the unit. Unity's FBX importer, glTFast, UnityGLTF and UniVRM 1.0 turn X. The same call goes
    /// both ways for the axis; `scale` is engine units a source unit.</summary>
    public static class Mirror
    {
        /// <summary>A Columns4x4 matrix from the engine's space to the source's, in place: the translation is divided by
        /// `scale`. For the palette, and for inverse bind matrices.</summary>
        public static void ToSource(float[] matrices, int at, Axis axis, float scale = 1)
        {
            int turned = (int)axis - 1;
            for (int column = 0; column < 4; ++column)
            {
                for (int row = 0; row < 3; ++row)
                {
                    float sign = (row == turned) != (column == turned) ? -1 : 1;
                    matrices[at + 4 * column + row] *= column == 3 ? sign / scale : sign;
                }
            }
        }

        /// <summary>A point of a result, from the source's space to the engine's.</summary>
        public static Vec3 PointToEngine(Vec3 p, Axis axis, float scale = 1)
        {
            Vec3 d = DirectionToEngine(p, axis);
            d.X *= scale;
            d.Y *= scale;
            d.Z *= scale;
            return d;
        }

        public static Vec3 DirectionToEngine(Vec3 d, Axis axis)
        {
            if (axis == Axis.X) d.X = -d.X;
            if (axis == Axis.Y) d.Y = -d.Y;
            if (axis == Axis.Z) d.Z = -d.Z;
            return d;
        }
    }
}
