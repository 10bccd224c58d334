// SPDX-License-Identifier: MIT
// Prints of Spherechain.Native.cs, by what the runtime makes of it, what generate.py --layout prints of the C headers.
// Every function must also be there in the library.
using System;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Linq;
using Spherechain;

public static class Layout
{
    static string Kind(Type type)
    {
        if (type == typeof(float)) return "float";
        if (type == typeof(int) || type.IsEnum) return "signed";
        if (type == typeof(uint) || type == typeof(ulong) || type == typeof(UIntPtr)) return "unsigned";
        return "other";
    }

    static int Size(Type type)
    {
        if (type.IsPointer) return IntPtr.Size;
        return Marshal.SizeOf(type.IsEnum ? Enum.GetUnderlyingType(type) : type);
    }

    static string Name(Type type)
    {
        if (type.IsPointer) return Name(type.GetElementType()) + "*";
        if (type == typeof(void)) return "void";
        if (type == typeof(byte)) return "byte";
        if (type == typeof(int)) return "int";
        if (type == typeof(uint)) return "uint";
        if (type == typeof(ulong)) return "ulong";
        if (type == typeof(float)) return "float";
        return type.Name;
    }

    static void PrintStruct(Type type)
    {
        Console.WriteLine("struct {0}: {1} bytes", type.Name, Marshal.SizeOf(type));
        foreach (FieldInfo field in type.GetFields(BindingFlags.Public | BindingFlags.Instance))
        {
            bool isArray = field.GetCustomAttribute<System.Runtime.CompilerServices.FixedBufferAttribute>() != null;
            Console.WriteLine("field {0}.{1} at {2}, {3} bytes, {4}", type.Name, field.Name, Marshal.OffsetOf(type, field.Name),
                              Size(field.FieldType), isArray ? "array" : Kind(field.FieldType));
        }
    }

    public static int Main()
    {
        foreach (Type type in typeof(Native).Assembly.GetTypes())
        {
            bool isOfNative = type.IsPublic || (type.IsNestedPublic && type.DeclaringType == typeof(Native));
            if (!isOfNative) continue;
            if (type.IsEnum)
            {
                foreach (object value in Enum.GetValues(type)) Console.WriteLine("enum {0}.{1} {2}", type.Name, value, (int)value);
                Console.WriteLine("enum {0}: {1} bytes", type.Name, Size(type));
            }
            else if (type.IsValueType)
            {
                PrintStruct(type);
            }
        }
        foreach (FieldInfo field in typeof(Native).GetFields().Where(f => f.FieldType == typeof(uint)))
        {
            Console.WriteLine("constant {0} {1}", field.Name, field.GetRawConstantValue());
        }
        foreach (MethodInfo method in typeof(Native).GetMethods().Where(m => m.IsStatic))
        {
            Marshal.Prelink(method);
            Console.WriteLine("function {0} {1}({2})", Name(method.ReturnType), method.Name,
                              string.Join(", ", method.GetParameters().Select(p => Name(p.ParameterType))));
        }
        return 0;
    }
}
