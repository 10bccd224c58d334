// SPDX-License-Identifier: MIT
// The types of UnrealBuildTool that the plugin's rules use, from their documentation, and a program that runs the rules for a platform:
// Rules.exe PLUGIN PLATFORM. It prints what they add; a file that is not there is an error.
using System;
using System.Collections.Generic;
using System.IO;

namespace UnrealBuildTool
{
    public enum UnrealTargetPlatform { Win64, Linux, Mac }

    public class ReadOnlyTargetRules { public UnrealTargetPlatform Platform; }

    public class Dependencies : List<string> { }

    public class ModuleRules
    {
        public enum PCHUsageMode { UseExplicitOrSharedPCHs }
        public static string Plugin;

        public PCHUsageMode PCHUsage;
        public string PluginDirectory { get { return Plugin; } }
        public readonly List<string> PublicDependencyModuleNames = new List<string>(), PrivateDependencyModuleNames = new List<string>(),
                                     PublicSystemIncludePaths = new List<string>(), PublicDefinitions = new List<string>(),
                                     PublicAdditionalLibraries = new List<string>(), PublicDelayLoadDLLs = new List<string>();
        public readonly Dependencies RuntimeDependencies = new Dependencies();

        public ModuleRules(ReadOnlyTargetRules target) { }
    }
}

public static class Rules
{
    static int missing;

    static void Files(string kind, IEnumerable<string> paths)
    {
        foreach (string path in paths)
        {
            bool exists = File.Exists(path) || Directory.Exists(path);
            if (!exists) ++missing;
            Console.WriteLine("{0} {1}{2}", kind, path, exists ? "" : " IS MISSING");
        }
    }

    public static int Main(string[] arguments)
    {
        UnrealBuildTool.ModuleRules.Plugin = arguments[0];
        UnrealBuildTool.ReadOnlyTargetRules target = new UnrealBuildTool.ReadOnlyTargetRules
        {
            Platform = (UnrealBuildTool.UnrealTargetPlatform)Enum.Parse(typeof(UnrealBuildTool.UnrealTargetPlatform), arguments[1])
        };
        foreach (UnrealBuildTool.ModuleRules rules in new UnrealBuildTool.ModuleRules[] { new Spherechain(target), new SpherechainEditor(target) })
        {
            Files("include", rules.PublicSystemIncludePaths);
            Files("library", rules.PublicAdditionalLibraries);
            Files("runtime", rules.RuntimeDependencies);
            foreach (string definition in rules.PublicDefinitions) Console.WriteLine("define {0}", definition);
            foreach (string module in rules.PublicDependencyModuleNames) Console.WriteLine("module {0}", module);
            foreach (string dll in rules.PublicDelayLoadDLLs)
            {
                Console.WriteLine("delayed {0}", dll);
                if (!rules.RuntimeDependencies.Exists(path => Path.GetFileName(path) == dll)) ++missing;
            }
        }
        return missing == 0 ? 0 : 1;
    }
}
